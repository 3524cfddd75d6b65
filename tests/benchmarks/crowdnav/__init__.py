"""Episodes of the suite crowdnav_circle_v1 on record, and the script that writes them."""
