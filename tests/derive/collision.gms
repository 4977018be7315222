$title Names that a derivation would like to have are taken, long names, several dimensions
set i / a, b /, i2 / c, d /, any1 / e /, y_row(i) / a /;
alias (i,i3,ii);
parameter y_e1(i) / a 2, b 3 /, has_up_x(i) / a 1 /, dual_x / 4 /, l_x / 2 /, this_is_a_name_of_an_equation_with_very_many_characters_to_be_01 / 1 /;
variables x(i,i3,i2), y_lim(i), obj, dual_objective; positive variable x;
equations e1(i), lim(i,i2), stat_x(i), objective_row, a_very_long_name_of_an_equation_with_almost_sixty_three_char(i);
e1(i)..       sum((ii,i2), y_e1(ii)*x(i,ii,i2)) + y_lim(i) =g= dual_x;
lim(i,i2)..   sum(i3, x(i3,i,i2) + 2*x(i,i3,i2)) =l= 9 + l_x$y_row(i);
stat_x(i)..   y_lim(i) - dual_objective =l= has_up_x(i);
a_very_long_name_of_an_equation_with_almost_sixty_three_char(i)..   sum(i2, x(i,i,i2)) =g= this_is_a_name_of_an_equation_with_very_many_characters_to_be_01;
objective_row.. obj =e= sum((i,i3,i2), (1 + ord(i) + ord(i3)*ord(i2))*x(i,i3,i2)) + 3*sum(i, y_lim(i)) + dual_objective;
x.up(i,i3,i2) = 5; y_lim.lo(i) = -1; dual_objective.lo = -2;
model kkt_m / all /;
solve kkt_m using lp minimizing obj;
