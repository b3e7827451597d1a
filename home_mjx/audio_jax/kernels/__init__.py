"""The two parts of a moving frame: paths read and added up, and responses with their tails; by XLA, and by CUDA."""
