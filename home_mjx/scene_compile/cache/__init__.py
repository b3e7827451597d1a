"""Compiled houses on disk: entries, the cache, the job that fills it, which houses to take."""
