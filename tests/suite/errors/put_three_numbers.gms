* Behind an item of `put` stand a width and decimals, no third number.
file f / 'put_three_numbers.txt' /;  put f;
put 1:8:2;
put 1:8:2:1;
*! error 4
