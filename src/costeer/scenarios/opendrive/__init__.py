"""Roads of OpenDRIVE files, and scenarios' roads as such files."""
