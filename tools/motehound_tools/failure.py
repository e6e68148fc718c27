"""What goes wrong for a reason that the user can mend."""


class Failure(Exception):
    """Its text is one line: what is wrong, where, and what was expected."""
