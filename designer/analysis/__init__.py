"""From a study to everything that is known of it: computed here, shown by the report."""
