"""Equations of the pages as MathML, which a browser draws by itself: a hook of MkDocs, without scripts and fonts."""

from __future__ import annotations

import re
from html import unescape
from typing import Any

from latex2mathml.converter import convert

# As pymdownx.arithmatex writes $...$ and $$...$$.
FORMULA = re.compile(r'<(span|div) class="arithmatex">\s*\\[(\[](.*?)\\[)\]]\s*</\1>', re.DOTALL)


# Names of functions, which latex2mathml sets without the thin spaces that they have in TeX.
FUNCTION = re.compile(r"<mi>(sin|cos|tan|tanh|ln|exp|min|max)</mi>")


def on_page_content(html: str, **_: Any) -> str:
    """The HTML of a page with MathML in place of TeX."""
    return FORMULA.sub(_typeset, html)


def _typeset(found: re.Match[str]) -> str:
    display = "block" if found[1] == "div" else "inline"
    formula = convert(unescape(found[2]).strip(), display=display)
    formula = FUNCTION.sub(r'<mo lspace="0.17em" rspace="0.17em">\1</mo>', formula)
    return f'<div class="equation">{formula}</div>' if display == "block" else formula
