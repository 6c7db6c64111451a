! Evaluate a golden function in Fortran 2008: gfortran -O2 function.f90 -o function && ./function FOLDER 17.25 3600
! Prints t, x, y, z, vx, vy, vz for each time; docs/format.md specifies the files and every operation.
program evaluate
  use, intrinsic :: iso_fortran_env, only: real64
  implicit none
  character(:), allocatable :: json
  character(4096) :: word
  real(real64), allocatable :: c(:, :, :), times(:)
  real(real64) :: t, a, b, w, u, y, square, s(6), b0, b1, b2, d0, d1, d2
  integer :: degree, series, pieces, size, at, n, i, k, low, high, middle
  call get_command_argument(1, word)
  open (10, file=trim(word)//'/function.json', access='stream', form='unformatted', status='old')
  inquire (10, size=size)
  allocate (character(size) :: json)
  read (10) json
  at = after('degree')
  read (json(at:at + index(json(at:), ',') - 2), *) degree
  at = after('length_squared')
  series = merge(3, 2, json(at:at) == 'n')
  if (series == 2) square = next_number()
  open (11, file=trim(word)//'/function.f64', access='stream', form='unformatted', status='old')
  inquire (11, size=size)
  pieces = size/(8*series*(degree + 1))
  allocate (c(0:degree, series, pieces), times(pieces + 1))
  read (11) c ! of a little-endian processor
  at = after('times')
  do n = 1, pieces + 1
    times(n) = next_number()
  end do
  do n = 2, command_argument_count()
    call get_command_argument(n, word)
    read (word, *) t
    if (.not. (t >= 0 .and. t <= times(pieces + 1))) error stop 'a time is not within the span'
    low = 1; high = pieces + 1 ! times(low) <= t, and t < times(high) but at the very end
    do while (high - low > 1)
      middle = (low + high)/2
      if (times(middle) <= t) then
        low = middle
      else
        high = middle
      end if
    end do
    a = times(low); b = times(high); w = b - a
    u = ((t - a) - (b - t))/w
    y = u + u
    do i = 1, series
      b1 = 0; b2 = 0; d1 = 0; d2 = 0
      do k = degree, 1, -1
        b0 = (y*b1 - b2) + c(k, i, low)
        d0 = (y*d1 - d2) + k*c(k, i, low)
        b2 = b1; b1 = b0; d2 = d1; d1 = d0
      end do
      s(i) = (u*b1 - b2) + c(0, i, low)
      s(i + 3) = (d1 + d1)/w
    end do
    if (series == 2) then
      s(3) = -sqrt(square - (s(1)*s(1) + s(2)*s(2)))
      s(6) = -(s(1)*s(4) + s(2)*s(5))/s(3)
    end if
    print '(7es25.16e3)', t, s
  end do
contains
  integer function after(key) ! where the value of a key begins
    character(*), intent(in) :: key
    after = index(json, '"'//key//'": ') + len(key) + 4
  end function

  real(real64) function next_number() ! the next hexfloat, "0x1.8p+3"
    integer :: i, exponent, power
    at = at + index(json(at:), '0x') + 1
    power = index(json(at:), 'p') - 1
    next_number = 0
    do i = 0, power - 1
      if (i /= 1) next_number = 16*next_number + index('0123456789abcdef', json(at + i:at + i)) - 1
    end do
    read (json(at + power + 1:at + index(json(at:), '"') - 2), *) exponent
    next_number = scale(next_number, exponent - 4*(power - 2))
  end function
end program
