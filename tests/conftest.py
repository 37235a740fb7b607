"""What holds for all tests."""


def pytest_collection_modifyitems(items):
    """Files with slow tests first: workers that share the files end at the same time."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in slow)
