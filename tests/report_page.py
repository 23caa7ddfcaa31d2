"""The report's page, read as a browser would, and what has to be true of any. Standard library only."""
import html.parser
import re
import shutil

VOID = {"br", "col", "hr", "img", "input", "link", "meta"}


def copy_sources(checkout, root):
    """What the report reads of a checkout."""
    for folder, pattern in (("experiments", "*.toml"), ("paper_figs", "*.gp"), ("experiments/page", "page.*"), ("experiments/nist", "*.dat")):
        (root / folder).mkdir(parents=True, exist_ok=True)
        for file in (checkout / folder).glob(pattern):
            shutil.copy(file, root / folder)


class Node:
    def __init__(self, name, attributes, parent):
        self.name, self.attributes, self.parent, self.children = name, attributes, parent, []

    def all(self, name=None, **attributes):
        """Elements within that have the name and these attributes; of a class it is enough to be among them."""
        for child in self.children:
            if isinstance(child, Node):
                given = {key.replace("_", "-").strip("-"): value for key, value in attributes.items()}
                if name in (None, child.name) and all(
                    value in (child.attributes.get(key) or "").split() if key == "class" else child.attributes.get(key) == value
                    for key, value in given.items()
                ):
                    yield child
                yield from child.all(name, **attributes)

    def one(self, name=None, **attributes):
        found = list(self.all(name, **attributes))
        if len(found) != 1:
            raise AssertionError(f"{len(found)} elements {name} {attributes}")
        return found[0]

    def text(self):
        return re.sub(r"\s+", " ", "".join(c if isinstance(c, str) else c.text() for c in self.children)).strip()

    def table(self):
        """Rows of a <table> as dicts."""
        header = [cell.text() for cell in next(self.all("thead")).all("th")]
        return [dict(zip(header, (c.text() for c in row.children if isinstance(c, Node)), strict=True))
                for row in next(self.all("tbody")).all("tr")]


class Reader(html.parser.HTMLParser):
    """Refuses what a browser would have to correct."""

    def __init__(self):
        super().__init__()
        self.root = self.at = Node("", {}, None)

    def handle_starttag(self, name, attributes):
        if len(dict(attributes)) != len(attributes):
            raise AssertionError(f"{self.getpos()}: an attribute twice in <{name}>")
        node = Node(name, dict(attributes), self.at)
        self.at.children.append(node)
        if name not in VOID:
            self.at = node

    def handle_endtag(self, name):
        if name != self.at.name:
            raise AssertionError(f"{self.getpos()}: </{name}> within <{self.at.name}>")
        self.at = self.at.parent

    def handle_data(self, data):
        self.at.children.append(data)

    def error(self, message):
        raise AssertionError(message)


def read_page(path):
    """The <html> of a page that is well formed."""
    reader = Reader()
    reader.feed(path.read_text(encoding="utf-8"))
    reader.close()
    if reader.at is not reader.root:
        raise AssertionError(f"<{reader.at.name}> is never closed")
    return reader.root.one("html")


def check_page(test, path, claims):
    """What has to be true of every report; `claims`: those of claims.json. Returns the page."""
    page = read_page(path)
    test.assertLessEqual(path.stat().st_size, 10e6)
    test.assertEqual(page.attributes["lang"], "en")
    ids = [node.attributes["id"] for node in page.all() if "id" in node.attributes]
    test.assertEqual(len(ids), len(set(ids)), "an id twice")
    for node in page.all():
        for key in ("src", "srcset", "poster", "data", "action"):
            test.assertTrue(node.attributes.get(key, "data:").startswith("data:"), f"{node.name} loads {node.attributes.get(key)}"[:200])
        test.assertNotIn(node.name, ("link", "iframe", "object", "embed", "base"))
        test.assertNotIn("style", node.attributes)
        test.assertFalse([key for key in node.attributes if key.startswith("on")])
        href = node.attributes.get("href", "#main")
        test.assertTrue(href.startswith("#") and href[1:] in ids, f"a link to {href}, which is not in the page")
        if node.name == "th":
            test.assertIn(node.attributes.get("scope"), ("col", "row"))
        if node.name == "img":
            test.assertGreater(len(node.attributes["alt"]), 40, "alt: what is to be seen")
    css = page.one("style").text()
    test.assertFalse(re.findall(r"url\(|@import", css))
    test.assertEqual(len(list(page.all("script"))), 1)
    test.assertEqual(len(list(page.all("main"))), 1)

    def told(finding):
        return tuple(finding[key] for key in ("id", "profile", "run", "verdict", "by_the_rule"))

    shown = []
    for node in page.all("div", class_="finding"):
        a = node.attributes
        mark = next(node.all("span", class_="verdict"))
        test.assertEqual(mark.text(), a["data-verdict"])
        test.assertEqual(mark.attributes["class"], "verdict " + a["data-verdict"].replace(" ", "-"))
        shown.append((a["data-claim"], a["data-profile"], a["data-run"], a["data-verdict"], a["data-by-the-rule"]))
    test.assertEqual(shown, [told(finding) for finding in claims])
    for finding in claims:
        article = page.one("article", id=finding["id"]).text()
        for key in ("paper", "rule", "reason", "sentence"):
            test.assertIn(re.sub(r"\s+", " ", finding[key]), article)
    rows = page.one("table", id="claims-table").table()
    test.assertEqual([row["Claim"] for row in rows], list(dict.fromkeys(finding["id"] for finding in claims)), "a line of each")
    for finding in claims:
        if finding["run"]:
            article = page.one("article", id=finding["id"]).text()
            for other in finding["readings"] + finding["former"]:
                for key in ("rule", "reason"):
                    test.assertIn(re.sub(r"\s+", " ", other[key]), article)
    verdicts = {}
    for finding in claims:
        if finding["profile"] == "paper":
            verdicts.setdefault(finding["id"], set()).add(finding["verdict"])
    for row in rows:
        test.assertTrue(any(row["Verdict"].startswith(verdict) for verdict in verdicts[row["Claim"]] | {"not run"}), row)
    return page
