"""The second generator of procedural houses: homes of up to three storeys, in SUNCG's on-disk format."""
