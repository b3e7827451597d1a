"""Tasks outside the common rules: exploration, and a task that controls agents itself."""
