"""Kitchen cabinets, sinks, cookers and hoods."""
