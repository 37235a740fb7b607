"""As in `launch.actions`."""


class DeclareLaunchArgument:
    def __init__(self, name: str, default_value: str) -> None:
        self.name, self.default = name, default_value
