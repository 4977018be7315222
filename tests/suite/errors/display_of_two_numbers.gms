* A display specification has one number, or three.
parameter q(*,*) / a.b 1 /;
option q:2:1;
*! error 3
