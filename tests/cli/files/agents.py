"""Agents that read and write."""


def east(text: str) -> str:
    return "east"


def mute(text: str) -> str:
    return ""


def talkative(messages: list[dict[str, str]]) -> str:
    return f"This is message {len(messages)}.\nGo east!"


def broken(text: str) -> str:
    replies: dict[str, str] = {}
    return replies["first"]
