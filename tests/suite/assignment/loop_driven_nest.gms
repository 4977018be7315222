* What is searched of q in loops around an assignment: all positions up to the first that runs in the assignment;
* indices of outer loops only where these hold nothing else.
set i /a, b/, t /c, d/;  alias (i,j), (t,u);
parameter p(i), got(*), w(i) /a 1/, v(t) /c 1/;
parameter q(i,t) /a.c 1, b.c 1/, r(t,i) /c.a 1/, h(t,i,t) /c.a.c 1/;
scalar s;

p(i) = 7;  loop(j$sameas(j,'b'), p(i) = q(j,'d'));                               got('label behind') = p('a');
p(i) = 7;  loop(j$sameas(j,'a'), p(i) = r('d',j));                               got('label ahead') = p('a');
p(i) = 7;  loop(j$sameas(j,'a'), p(i) = h('c',j,'d'));                           got('labels around') = p('a');
p(i) = 7;  loop((j,u)$(sameas(j,'a') and sameas(u,'d')), p(i) = q(j,u));         got('in order') = p('a');
p(i) = 7;  loop((u,j)$(sameas(j,'b') and sameas(u,'d')), p(i) = q(j,u));         got('other order') = p('a');
p(i) = 7;  loop((j,u)$(sameas(j,'b') and sameas(u,'c')), p(i) = q(j,'d')*v(u));  got('innermost elsewhere') = p('a');
p(i) = 7;  loop(j, p(i) = 1$sameas('c','d'));                                    got('labels alone') = p('a');

p(i) = 7;  loop(u$sameas(u,'d'), loop(j$sameas(j,'a'), p(i) = v(u)));            got('nest') = p('a');
p(i) = 7;  loop(u$sameas(u,'d'), if(1, loop(j$sameas(j,'a'), p(i) = v(u))));     got('nest in if') = p('a');
p(i) = 7;  loop(u$sameas(u,'d'), loop(j$sameas(j,'a'), p(i) = v(u)); s = 1);     got('outer') = p('a');
p(i) = 7;  loop(u$sameas(u,'d'), loop(j$sameas(j,'a'), p(i) = r(u,j)); s = 1);   got('outer ahead') = p('a');
p(i) = 7;  loop(u$sameas(u,'d'), loop(j$sameas(j,'b'), p(i) = q(j,u)); s = 1);   got('outer behind') = p('a');
p(i) = 7;  loop(u$sameas(u,'d'), loop(j, p(i) = w(j)$sameas(u,'c')); s = 1);     got('outer sameas') = p('a');
*= got('label ahead') 7
*= got('labels around') 7
*= got('in order') 7
*= got('nest') 7
*= got('nest in if') 7
*= got('outer ahead') 7
*= got('label behind') 7
*= got('other order') 7
*= got('innermost elsewhere') 7
*= got('labels alone') 0
*= got('outer') 0
*= got('outer behind') 7
*= got('outer sameas') 0
