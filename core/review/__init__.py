"""What people say of the findings of a result: records that are only ever added, and what holds after all of them."""
