"""What cannot be tried because a package is not installed: soaks also run where only the package itself is."""


def missing_package(error: BaseException | None) -> str:
    """The package that an error, or what led to it, asks for; else nothing."""
    while error is not None:
        if isinstance(error, ModuleNotFoundError) and error.name:
            return error.name.partition(".")[0]
        error = error.__cause__
    return ""
