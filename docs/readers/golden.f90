! Read a golden dataset in Fortran, as quadruple precision from decimals: gfortran golden.f90 -o golden && ./golden data/golden/paris
program golden
  use, intrinsic :: iso_fortran_env, only: real128
  implicit none
  character(len=20000) :: line, folder
  character(len=2), parameter :: names(6) = [character(len=2) :: 'x', 'y', 'z', 'vx', 'vy', 'vz']
  real(real128) :: row(7), bounds(6), passage(9), largest
  integer :: rows, transits, i, at, status

  call get_command_argument(1, folder)
  open (10, file=trim(folder)//'/grid.csv', status='old', action='read')
  read (10, '(a)') line  ! the header: t,x,y,z,vx,vy,vz
  do rows = 0, huge(rows) - 1
    read (10, *, iostat=status) row
    if (status /= 0) exit
  end do
  open (11, file=trim(folder)//'/manifest.json', status='old', action='read')
  line = ''
  do while (index(line, '"transit_s"') == 0)  ! the columns' bounds follow, in this order
    read (11, '(a)') line
  end do
  read (11, '(a)') line
  do i = 1, 6
    read (11, '(a)') line
    at = index(line, ': "')
    read (line(at + 3:at + 2 + index(line(at + 3:), '"') - 1), *) bounds(i)
  end do
  print '(a, i0, / a, es45.35e4)', 'grid ', rows, 't ', row(1)
  print '(a2, 2es45.35e4)', (names(i), row(i + 1), bounds(i), i = 1, 6)
  open (12, file=trim(folder)//'/transits.csv', status='old', action='read', iostat=status)
  if (status /= 0) stop  ! a scene without transits
  read (12, '(a)') line  ! the header: k,t,direction,x,y,z,vy,ax,bound
  largest = 0
  do transits = 0, huge(transits) - 1
    read (12, *, iostat=status) passage
    if (status /= 0) exit
    largest = max(largest, passage(9))
  end do
  print '(a, i0, es45.35e4)', 'transits ', transits, largest
end program
