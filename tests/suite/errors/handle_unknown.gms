* `handleDelete` and `handleSubmit` of what was never submitted are errors.
scalar a, b;
a = handleDelete(5);
b = handleSubmit(5);
*= a 1
*= b 2
*! execution 3
*! execution 4
