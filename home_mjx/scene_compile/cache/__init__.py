"""On-disk cache of compiled houses: entries, the cache itself, the compile job and house selection."""
