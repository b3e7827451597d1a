"""Small things: decoration, books, toys, clothes, electronics."""
