"""The environment, its automatic reset, saved episodes."""
