* Neither a domain nor data say how many indices there are.
parameter p / /;
*! error 2
