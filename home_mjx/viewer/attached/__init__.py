"""Viewers beside a running job: training, episodes of `play`, or an environment in a notebook."""
