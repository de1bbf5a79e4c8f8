"""The medial axis of a shape, wall thickness, and largest inscribed disks."""
