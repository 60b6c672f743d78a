"""Thin rclpy shells around the components; nothing else in the package imports rclpy."""
