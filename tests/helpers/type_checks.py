"""The type checker of all tests; a name of its own, since jaxtyping's option splits at commas within parentheses."""

import beartype

# An int is fine where a float is expected, as type checkers have it (PEP 484).
typechecker = beartype.beartype(conf=beartype.BeartypeConf(is_pep484_tower=True))
