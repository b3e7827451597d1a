"""Options, state, keys and poses that tasks and sensors share."""
