"""Kitchen units, appliances, crockery and food."""
