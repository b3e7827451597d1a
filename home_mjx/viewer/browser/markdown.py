"""Markdown of panels: text of files is shown as it is, never as markup or a script of the page.

viser's client renders HTML inside Markdown, with scripts.
"""

import re
from collections.abc import Iterable, Mapping

MARKUP = re.compile(r"""[&<>"'`*_{}\[\]|#~!$\\^]""")  # characters that Markdown, MDX or HTML can take for markup


def escape_markdown(text: object) -> str:
    """Return a text, on one line, of which Markdown shows each character: markup becomes character references.

    Args:
        text: The text; other objects as `str` gives them.

    Example:
        >>> escape_markdown("<b>hall</b> 12.5 m")
        '&#60;b&#62;hall&#60;/b&#62; 12.5 m'
    """
    return MARKUP.sub(lambda found: f"&#{ord(found.group())};", " ".join(str(text).split()))


def format_table(rows: Mapping[str, object]) -> str:
    """Return a table of names and values, one row each; both are escaped.

    Example:
        >>> print(format_table({"rooms": 4, "house": "a|b"}))
        | | |
        |---|---|
        | rooms | 4 |
        | house | a&#124;b |
    """
    lines = [f"| {escape_markdown(name)} | {escape_markdown(value)} |" for name, value in rows.items()]
    return "\n".join(["| | |", "|---|---|", *lines])


def format_list(items: Iterable[tuple[object, object, bool]]) -> str:
    """Return a list with one line for each item; all texts are escaped.

    Args:
        items: The word that begins a line, the text that follows it, and whether the word is bold.

    Example:
        >>> print(format_list([(7, "touches the bed", False), (9, "reward +1.00", True)]))
        - 7 touches the bed
        - **9** reward +1.00
    """
    marks = {True: "**", False: ""}
    return "\n".join(
        f"- {marks[is_bold]}{escape_markdown(word)}{marks[is_bold]} {escape_markdown(text)}"
        for word, text, is_bold in items
    )
