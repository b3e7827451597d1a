"""Light sources and glossy surfaces of a house."""
