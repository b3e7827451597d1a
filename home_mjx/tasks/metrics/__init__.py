"""What is told of an episode that no agent observes."""
