#!/usr/bin/env python3
"""The report: one self-contained page with every figure; and its refusals."""

import html.parser
import unittest

from program import HIL, ProgramTest

FIGURES = ("4.4", "4.5", "5.1", "5.2", "5.3", "5.4", "5.5", "6.1", "6.2", "6.3", "6.4", "6.5", "6.6",
           "6.7", "6.8", "6.9", "7.1", "7.3", "7.4", "7.12", "7.14", "7.25", "7.26", "7.34", "B.2")
VOID = {"meta", "img", "input"}


class Page(html.parser.HTMLParser):
    """Checks that tags are closed in order; collects links to other files, and captions."""

    def __init__(self, text):
        super().__init__()
        self.open, self.loads, self.captions, self.pictures = [], [], [], 0
        self.headings, self.lead, self.boxes, self.tables = [], "", 0, 0
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.boxes += attributes.get("class") == "box"
        self.tables += tag == "table"
        if tag == "img":
            self.pictures += attributes["src"].startswith("data:image/png;base64,iVBOR")
        self.loads += [v for k, v in attributes.items()
                       if k in ("src", "href") and not v.startswith(("data:", "#"))]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        if self.open and self.open[-1] == "h2":
            self.headings.append(data)
        if self.open and self.open[-1] == "p" and not self.lead:
            self.lead = data
        if self.open and self.open[-1] == "figcaption":
            self.captions.append(data)


class Report(ProgramTest):
    def test_is_one_self_contained_page_with_every_figure(self):
        folder = self.folder / "report"
        page_file = self.flexarm_json("report", "-c", HIL, "-o", folder, timeout_s=280)["page"]
        text = (folder / "report.html").read_text()
        self.assertEqual(page_file, str(folder / "report.html"))
        page = Page(text)
        self.assertEqual((page.open, page.loads), ([], []))
        self.assertGreaterEqual(page.pictures, 16)
        captions = " ".join(page.captions)
        self.assertEqual(page.headings[:5], ["The arm", "Main result", "Summary",
                                             "The thesis's statements", "Contents"])
        self.assertRegex(page.lead, r"^Computed on \d{4}-\d{2}-\d{2} by flexarm \d")
        self.assertEqual(page.boxes, page.tables + page.pictures, "what does not scroll by itself")
        self.assertIn("to scale", page.captions[0])
        for figure in FIGURES:
            self.assertIn(figure, captions)
        for chapter in (3, 4, 5, 6, 7):
            self.assertIn(f"Chapter {chapter}", text)
        for said in ("harmonic drive of 48.96:1", "optical encoder 4", "Ratio 2", "1.43e-7",
                     "Section 7.2", "Appendix B"):  # Tables 1 and 2, chapters of their own
            self.assertIn(said, text)
        self.assertIn("What limits the laws that estimate the payload", captions)
        for cell in ("gain-scheduled", "encoders-x10", "reached"):
            self.assertIn(f"<td>{cell}</td>", text)
        for verdict in ("holds", "does not hold", "holds in part"):
            self.assertIn(f">{verdict}</td>", text)
        self.assertIn("Published arms", text)
        self.assertIn("<td>differs, see the note</td>", text)
        self.assertNotIn("<td>DIFFERS</td>", text)
        self.assertNotIn("no finite number", text)
        for run in (folder / "runs").iterdir():
            self.flexarm_json("replay", run)
        self.assert_refused(self.run_program("flexarm", "report", "-c", HIL, "-o", folder),
                            "is not empty")


if __name__ == "__main__":
    unittest.main()
