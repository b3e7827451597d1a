"""Reader of ProcTHOR's houses (JSON, schema 1.0.0) and their dialects, in furniture of the package's own."""
