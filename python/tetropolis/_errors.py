"""The exceptions of the package; each is one line that says what is wrong and what to do."""


class Error(Exception):
    """What the library refuses to do, or cannot."""


class UsageError(Error, ValueError):
    """A keyword that does not exist, a value out of its range, arguments that do not go together."""


class InputError(Error):
    """Input that cannot be used, or a file that cannot be written. The message names file and feature."""


class GuaranteeError(Error):
    """A guarantee cannot be met for this input; there is no result."""


class DataWarning(UserWarning):
    """Something odd about the data, which was used nevertheless."""
