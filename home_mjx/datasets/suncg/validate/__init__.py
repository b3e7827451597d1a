"""The rules that the validator adds to those of the reader. Each module has one function that takes a `Subject`."""
