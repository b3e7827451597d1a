"""Tasks as rows of arrays: what is meant, what must hold, what comes next; one program steps any mix of them."""
