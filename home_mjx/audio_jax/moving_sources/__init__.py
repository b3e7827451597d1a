"""Sound of sources and heads that move within a frame, and of rooms that ring for longer than a response."""
