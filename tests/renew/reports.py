"""Write the expected reports of `levels/bad` and `lint/rules` anew.

Read the difference before you keep it.

From the top of the repository: `PYTHONPATH=tests python -m renew.reports`
"""

from __future__ import annotations

from support.reports import BAD, LINT_BAD, lint_report, report

if __name__ == "__main__":
    for path in BAD:
        path.with_suffix(".txt").write_text(report(path), encoding="utf-8", newline="\n")
    for path in LINT_BAD:
        path.with_suffix(".txt").write_text(lint_report(path), encoding="utf-8", newline="\n")
    print(f"{len(BAD) + len(LINT_BAD)} reports")
