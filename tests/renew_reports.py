"""Write the expected reports of `levels/bad` anew. Read the difference before you keep it.

From the top of the repository: `PYTHONPATH=tests python tests/renew_reports.py`
"""

from __future__ import annotations

from support.reports import BAD, report

if __name__ == "__main__":
    for path in BAD:
        path.with_suffix(".txt").write_text(report(path), encoding="utf-8", newline="\n")
    print(f"{len(BAD)} reports")
