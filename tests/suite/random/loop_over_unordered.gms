* The records that tell which turns of a loop draw may have been written in any order.
set i / a*e /;  parameter q(i), n, next;  scalar turns / 0 /;
q('d') = 1;  q('b') = 2;  q('e') = 3;  q('a') = 4;  q('d') = 0;
loop(i$(q(i)$uniform(0,1)), turns = turns + 1);
next = uniform(0,1);
*= turns 3
*= next 0.301137904
