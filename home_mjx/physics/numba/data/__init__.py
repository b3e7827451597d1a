"""What the fused step works on: sizes, numbers and memory."""
