"""As in `launch.substitutions`."""


class LaunchConfiguration:
    def __init__(self, name: str) -> None:
        self.name = name

    def of(self, given: dict[str, str]) -> str:
        return given[self.name]  # one that was not declared is an error
