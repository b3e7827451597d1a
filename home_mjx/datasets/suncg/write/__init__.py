"""Writers of houses and models in SUNCG's format."""
