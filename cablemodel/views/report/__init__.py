"""A run as one self-contained page: HTML with everything inside, for people without this software.

``samples`` thins a run to what a screen can show, ``shape`` and ``charts`` draw, ``tables`` holds
the numbers, ``page`` puts all together with ``static/``.
"""

from cablemodel.views.report.page import report_html, save_report

__all__ = ["report_html", "save_report"]
