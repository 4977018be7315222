* Discrete variables have no scale, and others no priority.
integer variable n;
positive variable x;
n.scale = 10;
x.prior = 2;
*! error 4
*! error 5
