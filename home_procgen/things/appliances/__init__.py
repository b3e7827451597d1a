"""Kitchen appliances, washing machines and dishwashers."""
