"""One section of a wire: uniform coils, slices and solids against each other and against closed solutions."""
