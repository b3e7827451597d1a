"""Names of colours and materials."""
